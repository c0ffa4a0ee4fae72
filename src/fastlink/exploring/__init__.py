"""Maps in a browser: the page, the server of this machine, and facts as JavaScript for the page to move mechanisms."""
