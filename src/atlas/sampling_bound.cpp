// sampling_bound(): how far the surface may be from its samples.
