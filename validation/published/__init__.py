"""What is in print beside what gbeam answers: both papers number by number, and cases of the literature."""
