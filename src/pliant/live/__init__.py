"""The live page: the robot in a browser, with its parameters and curves.

The loop and the page run in two processes that share nothing but messages (`messages`, `link`). Modules of the loop's
side (`requests`, `steered_*`, `pace`, `watch`, `worker`) never import viser; those of the page's side never touch a
plant.
"""
