"""Table of the thesis's numbers beside what the program computes, with a verdict a row."""
