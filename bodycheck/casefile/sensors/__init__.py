"""Sensors in case files of both formats: the grammar of their tables, the rules between keys, and building them."""
