"""lab: the page for the classroom, served to a browser or written as pages that need no server."""
