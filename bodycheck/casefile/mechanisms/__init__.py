"""The format of case files for mechanisms, format 2: bodies on joints.

- `grammar` defines the keys and the allowed values; `faults` checks rules that connect several keys, on the raw document.
- `building` builds the mechanism of a case, and finds faults that only its initial state shows: loops that do not close, bodies
  whose motion is not determined, and numbers that would overflow.
"""
