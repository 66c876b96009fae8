"""Random planar mechanisms, and the laws that every engine has to obey on them."""
