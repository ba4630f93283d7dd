"""Other people's engines and libraries: what they answer, and the section that a report has of it."""
