"""Which steps a run takes, how well they are known, and the runs that are put together of them."""
