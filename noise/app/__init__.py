"""The local app of ``bushing-noise open``: a small server, and what it shows in the browser.

Each view is a folder with the routes that it needs (`routes`), and a script of the same name under
``static`` whose ``mount`` draws it. A new view is these two and a line in `noise.app.server.VIEWS`.
"""
