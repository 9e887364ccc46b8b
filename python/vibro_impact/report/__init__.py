"""A report of a recorded run: one HTML page with interactive charts, which needs nothing but a browser.

The way of the data: run (reads), spectra and segments (compute), *_charts and step_data (what is drawn), document
(which sections there are), page (HTML around it), command (the command line). """
