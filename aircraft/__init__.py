"""The aircraft: JSBSim models, the SI boundary to JSBSim, the reference curve and guidance."""
