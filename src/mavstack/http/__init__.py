"""HTTP for the parts of Mavstack that serve it: the server, bodies of requests, requests of web pages."""
