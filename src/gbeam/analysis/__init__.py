"""One folder per family of questions. Reads objects, returns records; nothing here opens a file, draws or prints."""
