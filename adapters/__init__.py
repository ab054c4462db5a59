"""Physics engines, one file each, behind the contract of `bodycheck.adapters.contract`."""
