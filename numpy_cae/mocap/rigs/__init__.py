"""The twenty joints of any rig: found by name, by the hierarchy, or given by a mapping."""
