"""Models of other programs in their files: one reader for each family of formats, and the registry of them."""
