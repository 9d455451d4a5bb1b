"""Readers and writers between text files and `Motion`, in the axes and joints of the file."""
