"""Teaching: exercises that grade their answers, and the page for the classroom."""
