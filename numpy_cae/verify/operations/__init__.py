"""The properties of the operations: what must hold of each, and the cases it is tried on."""
