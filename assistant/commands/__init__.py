"""The commands of `d3a`: one module each, its `command` loaded when it is called."""
