"""What every part of the program uses: whole files, tables, progress."""
