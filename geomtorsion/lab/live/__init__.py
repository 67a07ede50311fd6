"""live: the lab as a folder of files, in which everything exact runs in the browser itself."""
