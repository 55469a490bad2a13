"""The estimates of one method by PySPH, for bench_engine: the same particles, the same sums.

Called as  pysph_reference.py FOLDER DIMENSION KERNEL H METHOD REPETITIONS
FOLDER/particles holds N rows of doubles x y z V A. Writes the estimates (value and gradient, N rows
of four doubles) to FOLDER/estimates and prints the processor seconds of each repetition, search included.
"""
import sys
import time

import numpy
from pysph.base.kernels import CubicSpline, WendlandQuinticC4
from pysph.base.nnps import LinkedListNNPS
from pysph.base.utils import get_particle_array
from pysph.sph.acceleration_eval import AccelerationEval
from pysph.sph.equation import Equation
from pysph.sph.sph_compiler import SPHCompiler

KERNELS = {'cubic-spline': CubicSpline, 'wendland-c4': WendlandQuinticC4}
SUMS = ('value', 'gx', 'gy', 'gz', 'w', 'wx', 'wy', 'wz',
        'm00', 'm01', 'm02', 'm10', 'm11', 'm12', 'm20', 'm21', 'm22')


class Sph(Equation):
    """Value and gradient, eq. 1."""

    def initialize(self, d_idx, d_value, d_gx, d_gy, d_gz):
        d_value[d_idx] = 0.0
        d_gx[d_idx] = 0.0
        d_gy[d_idx] = 0.0
        d_gz[d_idx] = 0.0

    def loop(self, d_idx, s_idx, d_value, d_gx, d_gy, d_gz, s_V, s_A, WIJ, DWIJ):
        c = declare('double')
        c = s_V[s_idx] * s_A[s_idx]
        d_value[d_idx] += c * WIJ
        d_gx[d_idx] += c * DWIJ[0]
        d_gy[d_idx] += c * DWIJ[1]
        d_gz[d_idx] += c * DWIJ[2]


class BonetLok(Equation):
    """Eqs. 27-28: Shepard's kernel differentiated, its gradient corrected."""

    def __init__(self, dest, sources, dim):
        self.dim = dim
        super(BonetLok, self).__init__(dest, sources)

    def initialize(self, d_idx, d_value, d_gx, d_gy, d_gz, d_w, d_wx, d_wy, d_wz, d_m00, d_m01,
                   d_m02, d_m11, d_m12, d_m22, d_m10, d_m20, d_m21, d_sx, d_sy, d_sz):
        d_value[d_idx] = 0.0
        d_gx[d_idx] = 0.0
        d_gy[d_idx] = 0.0
        d_gz[d_idx] = 0.0
        d_w[d_idx] = 0.0
        d_wx[d_idx] = 0.0
        d_wy[d_idx] = 0.0
        d_wz[d_idx] = 0.0
        d_sx[d_idx] = 0.0
        d_sy[d_idx] = 0.0
        d_sz[d_idx] = 0.0
        d_m00[d_idx] = 0.0
        d_m01[d_idx] = 0.0
        d_m02[d_idx] = 0.0
        d_m10[d_idx] = 0.0
        d_m11[d_idx] = 0.0
        d_m12[d_idx] = 0.0
        d_m20[d_idx] = 0.0
        d_m21[d_idx] = 0.0
        d_m22[d_idx] = 0.0

    def loop(self, d_idx, s_idx, d_value, d_gx, d_gy, d_gz, d_w, d_wx, d_wy, d_wz, d_m00, d_m01,
             d_m02, d_m10, d_m11, d_m12, d_m20, d_m21, d_m22, d_sx, d_sy, d_sz, s_V, s_A, d_A, XIJ,
             WIJ, DWIJ):
        w, c, gx, gy, gz = declare('double', 5)
        w = s_V[s_idx] * WIJ
        c = s_A[s_idx] - d_A[d_idx]
        gx = s_V[s_idx] * DWIJ[0]
        gy = s_V[s_idx] * DWIJ[1]
        gz = s_V[s_idx] * DWIJ[2]
        d_value[d_idx] += c * w
        d_gx[d_idx] += c * gx
        d_gy[d_idx] += c * gy
        d_gz[d_idx] += c * gz
        d_w[d_idx] += w
        d_wx[d_idx] += gx
        d_wy[d_idx] += gy
        d_wz[d_idx] += gz
        d_sx[d_idx] -= XIJ[0] * w
        d_sy[d_idx] -= XIJ[1] * w
        d_sz[d_idx] -= XIJ[2] * w
        d_m00[d_idx] -= XIJ[0] * gx
        d_m01[d_idx] -= XIJ[0] * gy
        d_m02[d_idx] -= XIJ[0] * gz
        d_m10[d_idx] -= XIJ[1] * gx
        d_m11[d_idx] -= XIJ[1] * gy
        d_m12[d_idx] -= XIJ[1] * gz
        d_m20[d_idx] -= XIJ[2] * gx
        d_m21[d_idx] -= XIJ[2] * gy
        d_m22[d_idx] -= XIJ[2] * gz

    def post_loop(self, d_idx, d_value, d_gx, d_gy, d_gz, d_w, d_wx, d_wy, d_wz, d_m00, d_m01,
                  d_m02, d_m10, d_m11, d_m12, d_m20, d_m21, d_m22, d_sx, d_sy, d_sz, d_A):
        w, bx, by, bz, px, py, pz, det = declare('double', 8)
        a00, a01, a02, a10, a11, a12, a20, a21, a22 = declare('double', 9)
        w = 1.0 / d_w[d_idx]
        px = d_wx[d_idx] * w
        py = d_wy[d_idx] * w
        pz = d_wz[d_idx] * w
        # Sums of the gradient of W/sum(W V): (grad W - W p)/w.
        bx = (d_gx[d_idx] - d_value[d_idx] * px) * w
        by = (d_gy[d_idx] - d_value[d_idx] * py) * w
        bz = (d_gz[d_idx] - d_value[d_idx] * pz) * w
        a00 = (d_m00[d_idx] - d_sx[d_idx] * px) * w
        a01 = (d_m01[d_idx] - d_sx[d_idx] * py) * w
        a02 = (d_m02[d_idx] - d_sx[d_idx] * pz) * w
        a10 = (d_m10[d_idx] - d_sy[d_idx] * px) * w
        a11 = (d_m11[d_idx] - d_sy[d_idx] * py) * w
        a12 = (d_m12[d_idx] - d_sy[d_idx] * pz) * w
        a20 = (d_m20[d_idx] - d_sz[d_idx] * px) * w
        a21 = (d_m21[d_idx] - d_sz[d_idx] * py) * w
        a22 = (d_m22[d_idx] - d_sz[d_idx] * pz) * w
        if self.dim == 2:
            a22 = 1.0
        d_value[d_idx] = d_value[d_idx] * w + d_A[d_idx]
        # Solve A^T g = b by Cramer's rule.
        det = (a00 * (a11 * a22 - a21 * a12) - a10 * (a01 * a22 - a21 * a02)
               + a20 * (a01 * a12 - a11 * a02))
        d_gx[d_idx] = (bx * (a11 * a22 - a21 * a12) - a10 * (by * a22 - a21 * bz)
                       + a20 * (by * a12 - a11 * bz)) / det
        d_gy[d_idx] = (a00 * (by * a22 - a21 * bz) - bx * (a01 * a22 - a21 * a02)
                       + a20 * (a01 * bz - by * a02)) / det
        d_gz[d_idx] = (a00 * (a11 * bz - by * a12) - a10 * (a01 * bz - by * a02)
                       + bx * (a01 * a12 - a11 * a02)) / det


def main():
    folder, dim, kernel, h, method, repetitions = sys.argv[1:]
    dim, h = int(dim), float(h)
    rows = numpy.fromfile(folder + '/particles').reshape(-1, 5)
    particles = get_particle_array(
        name='fluid', x=rows[:, 0], y=rows[:, 1], z=rows[:, 2], h=numpy.full(len(rows), h),
        V=rows[:, 3], A=rows[:, 4], additional_props=list(SUMS + ('sx', 'sy', 'sz')))
    kernel = KERNELS[kernel](dim=dim)
    equation = (Sph('fluid', ['fluid']) if method == 'sph' else
                BonetLok('fluid', ['fluid'], dim))
    evaluation = AccelerationEval([particles], [equation], kernel)
    SPHCompiler(evaluation, None).compile()
    nnps = LinkedListNNPS(dim=dim, particles=[particles], radius_scale=kernel.radius_scale)
    evaluation.set_nnps(nnps)
    for _ in range(int(repetitions)):
        start = time.process_time()
        nnps.update()
        evaluation.compute(0.0, 0.1)
        print('seconds %.6f' % (time.process_time() - start), flush=True)
    numpy.column_stack([getattr(particles, name) for name in SUMS[:4]]).tofile(
        folder + '/estimates')


main()
