/* Sine and cosine that are the same bits everywhere.
 *
 * A C library may compute them otherwise on another processor (with fused multiplications, say), and one last bit grows
 * in every chaotic scene.  Everything else that the engine calls is exactly rounded by IEEE 754: + - * / and sqrt.
 */
#ifndef ANGLE_H
#define ANGLE_H

void angle_sincos(double angle, double *sine, double *cosine);

#endif
