#version 330 core

// Writes the normal, turned to the viewer, and the depth; depth 0 is left to the background.

in vec3 camera_position;
in vec3 camera_normal;

layout(location = 0) out vec4 normal_and_depth;

const float CANCELLED = 1e-4;  // as in embree.py

void main()
{
    vec3 flat_normal = cross(dFdx(camera_position), dFdy(camera_position));  // always faces the viewer
    vec3 turned = gl_FrontFacing ? camera_normal : -camera_normal;
    vec3 normal = length(camera_normal) < CANCELLED ? flat_normal : turned;
    normal_and_depth = vec4(normalize(normal), -camera_position.z);
}
