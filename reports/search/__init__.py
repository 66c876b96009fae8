"""Random planar mechanisms, and the laws that every engine must obey for these mechanisms."""
