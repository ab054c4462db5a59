"""The worst members: `worst` writes them as case files, after `shrinking` by `trials`; `playing` animates them."""
