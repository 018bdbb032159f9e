"""Many recordings, one result each: in this process, in several, or on a cluster.

Whatever becomes of a process, nothing that was done is lost, nothing is done twice, and the table
is the same, byte for byte, as that of one process that nobody disturbed.
"""
