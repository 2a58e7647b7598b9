"""Inverses, from loads to axis motions: closed forms, the exact inverse, the planned one."""
