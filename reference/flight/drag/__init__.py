"""Translation with quadratic drag, with a bound of its error.

- `translation`: open this first. It combines the motion and its witness into positions and velocities with bounds.
- `motion`: the motion, composed of exact solutions, with its own error.
- `hodograph`: a curved path, by quadratures over its slope.
- `straight`: closed forms of straight paths, without gravity and along the vertical.
- `antiderivative`: integrals of smooth functions on panels, in the wide type.
- `witness`: the same motion, integrated in three coordinates by independent code; `taylor_flight` is the integration with
  heyoka.
"""
