// An imported mesh stands for the same ground as the terrain. Where it is compared with that, or with what is draped over
// it, it is taken to be nearer than it is by so many metres. @param most m @param distance along the view axis, m
float mesh_lift(float most, float distance) {
    return min(most, 0.03 * distance);
}
