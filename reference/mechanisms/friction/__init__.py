"""Trees whose joints have dry friction, in the recursion.

`stick_slip` follows their motion from change to change by heyoka, and `sticking` decides which joints with dry friction stick.
"""
