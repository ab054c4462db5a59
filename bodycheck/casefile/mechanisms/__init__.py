"""The format of case files for mechanisms, format 2: bodies on joints.

- `grammar` defines the keys and the allowed values; `faults` checks rules that connect several keys, on the raw document.
- `building` makes the mechanism of a case, and checks what only its start can tell: loops that do not close, bodies whose
  motion is not determined, and numbers that would overflow.
"""
