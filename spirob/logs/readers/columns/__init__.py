"""What all readers share: columns of a table.

table.py      what a reader is asked, and what it gives
sorting.py    any column to numbers: dates to seconds, texts that hold numbers to those
arrays.py     an array of any shape to columns
finishing.py  what holds for every table: names that print, short names, one length, a bound
"""
