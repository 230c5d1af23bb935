"""What all readers share: columns of a table.

table.py    what a reader is asked, and what it gives; an array of any shape to columns; what holds
            for every table: names that print, short names, one length, a bound
sorting.py  any column to numbers: dates to seconds, texts that hold numbers to those
"""
