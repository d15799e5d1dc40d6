#version 330 core

// Carries positions and normals from the world to the camera. pyrender puts NORMAL_LOC and INST_M_LOC in.

layout(location = 0) in vec3 position;
layout(location = NORMAL_LOC) in vec3 normal;
layout(location = INST_M_LOC) in mat4 inst_m;

uniform mat4 V;
uniform mat4 P;

out vec3 camera_position;
out vec3 camera_normal;

void main()
{
    vec4 seen = V * inst_m * vec4(position, 1.0);
    camera_position = seen.xyz;
    camera_normal = mat3(V) * normal;  // V and inst_m are rotations and shifts
    gl_Position = P * seen;
}
