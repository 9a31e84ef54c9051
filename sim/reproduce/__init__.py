"""The paper's experiments made again: weather days, policies, judging, figures and the page about them."""
