"""Which axis motions make a load: closed forms, the exact inverse, the planned one."""
