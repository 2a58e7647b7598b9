"""Parts of a response's result: its errors, peaks, section forces and outline."""
