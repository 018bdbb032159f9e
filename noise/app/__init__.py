"""Local web app of ``bushing-noise open``: server and browser views.

Each view is a module whose `routes` gives what it needs of the server, and a folder of the view's
name under ``static`` whose ``view.js`` draws it. A new view is these two and a line in
`noise.app.server.VIEWS`.
"""
