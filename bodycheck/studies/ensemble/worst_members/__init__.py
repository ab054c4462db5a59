"""The worst members: `worst` writes them as case files, simplified by `shrinking` with `trials`; `playing` animates them."""
