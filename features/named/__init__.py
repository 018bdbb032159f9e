"""The named features of a recording, declared one by one."""
