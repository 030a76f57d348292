//! Names over random places: never one over another, never outside, leaders never crossing.
