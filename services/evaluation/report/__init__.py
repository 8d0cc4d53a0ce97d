"""What stays of a lesson on paper and in files: attempts -> JSON, CSV, a page to print. Pure: feedbacks and names in, bytes out."""
