"""What a base does: flight (prescribed or recorded), a turning hub, how a beam is mounted on one."""
