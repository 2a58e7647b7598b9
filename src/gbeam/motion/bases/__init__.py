"""Motions of a base: flight (prescribed or recorded), a turning hub, how a beam is mounted on one."""
