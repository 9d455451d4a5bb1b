"""The marks of a class: who handed what in, the table of marks, and the file that is imported.

`handed_in` finds the files of a download, `roster` reads the list of the class, `matching` says
who is who, `tables` writes the marks, `feedback` a file for each student, `similar` lists pairs.
"""
