! A solver in Fortran: Heun's method (order 2) at the scene's step, contact forces by libpinwheel_law.
!
!     gfortran -O2 -o solver solver.f90 -L"$(pinwheel solver library)" -lpinwheel_law
!     pinwheel compare paper --solver solver.toml
!
! All bodies are pinned at their centres, so each has one unknown: its angle. The input turns at a constant rate.
module pinwheel
  use, intrinsic :: iso_c_binding
  implicit none
  integer, parameter :: dp = c_double
  interface
    integer(c_int32_t) function law_open(scene, law) bind(c, name="pinwheel_law_open")
      import; character(kind=c_char), intent(in) :: scene(*); type(c_ptr), intent(out) :: law
    end function
    integer(c_int32_t) function law_bodies(law) bind(c, name="pinwheel_law_bodies")
      import; type(c_ptr), value :: law
    end function
    integer(c_int32_t) function law_body(law, body, carrier, seat, mass, moment) bind(c, name="pinwheel_law_body")
      import; type(c_ptr), value :: law; integer(c_int32_t), value :: body
      integer(c_int32_t), intent(out) :: carrier; real(c_double), intent(out) :: seat(2), mass, moment
    end function
    real(c_double) function law_rate(law) bind(c, name="pinwheel_law_rate")
      import; type(c_ptr), value :: law
    end function
    real(c_double) function law_step(law) bind(c, name="pinwheel_law_step")
      import; type(c_ptr), value :: law
    end function
    integer(c_int64_t) function law_samples(law, times, room) bind(c, name="pinwheel_law_samples")
      import; type(c_ptr), value :: law; real(c_double) :: times(*); integer(c_int64_t), value :: room
    end function
    integer(c_int32_t) function law_start(law, states) bind(c, name="pinwheel_law_start")
      import; type(c_ptr), value :: law; real(c_double), intent(out) :: states(6, *)
    end function
    integer(c_int32_t) function law_loads(law, states, loads) bind(c, name="pinwheel_law_loads")
      import; type(c_ptr), value :: law; real(c_double), intent(in) :: states(6, *)
      real(c_double), intent(out) :: loads(3, *)
    end function
    real(c_double) function law_load_torque(law, time) bind(c, name="pinwheel_law_load_torque")
      import; type(c_ptr), value :: law; real(c_double), value :: time
    end function
    subroutine law_close(law) bind(c, name="pinwheel_law_close")
      import; type(c_ptr), value :: law
    end subroutine
    subroutine leave(status) bind(c, name="exit")
      import; integer(c_int), value :: status
    end subroutine
  end interface
  type(c_ptr) :: law
  integer :: n
  integer(c_int32_t), allocatable :: carrier(:)
  real(dp), allocatable :: seat(:, :), mass(:), moment(:), states(:, :), loads(:, :)
  real(dp) :: rate, output_moment
contains
  ! Says why, on the last line of stderr, and ends with a status of the protocol: 3 diverged, 4 unsupported, 1 else.
  subroutine give_up(status, what)
    integer, intent(in) :: status
    character(*), intent(in) :: what
    write (0, '(a)') what
    call leave(status)
  end subroutine

  ! Moment about the origin of the contact force on body k.
  pure real(dp) function turning(k)
    integer, intent(in) :: k
    turning = states(1, k) * loads(2, k) - states(2, k) * loads(1, k)
  end function

  ! Fills states and loads at time t from angles y(:, 1) and rates y(:, 2); slope becomes their derivative.
  subroutine evaluate(t, y, slope)
    real(dp), intent(in) :: t, y(n, 2)
    real(dp), intent(out) :: slope(n, 2)
    real(dp) :: c, s, spin, torque
    integer :: k
    do k = 1, n
      c = 1; s = 0; spin = 0
      if (carrier(k) >= 0) then
        c = cos(states(3, carrier(k) + 1)); s = sin(states(3, carrier(k) + 1)); spin = states(6, carrier(k) + 1)
      end if
      states(1, k) = c * seat(1, k) - s * seat(2, k)
      states(2, k) = s * seat(1, k) + c * seat(2, k)
      states(3, k) = merge(rate * t, y(k, 1), k == 1)
      states(4, k) = -spin * states(2, k)
      states(5, k) = spin * states(1, k)
      states(6, k) = merge(rate, y(k, 2), k == 1)
    end do
    if (law_loads(law, states, loads) /= 0) call give_up(3, 'no forces: the states are no numbers any more')
    torque = loads(3, 2) + law_load_torque(law, t)
    do k = 1, n
      if (carrier(k) == 1) torque = torque + turning(k)
    end do
    slope(:, 1) = states(6, :)
    slope(:, 2) = loads(3, :) / moment
    slope(1, 2) = 0
    slope(2, 2) = torque / output_moment
  end subroutine
end module

program solver
  use pinwheel
  implicit none
  character(4096) :: job
  integer :: k, step, steps, file, external_sleeves, internal_sleeves, wheels
  integer(c_int64_t) :: sample, samples, all
  real(dp) :: h, t, driver, output, nothing(1)
  real(dp), allocatable :: times(:), y(:, :), first(:, :), second(:, :)

  call get_command_argument(1, job)
  if (law_open(trim(job) // c_null_char, law) /= 0) call give_up(1, 'give a job folder whose scene.json can be read')
  n = law_bodies(law)
  rate = law_rate(law)
  samples = law_samples(law, nothing, 0_c_int64_t)
  allocate (carrier(n), seat(2, n), mass(n), moment(n), states(6, n), loads(3, n), times(samples))
  allocate (y(n, 2), first(n, 2), second(n, 2))
  if (law_samples(law, times, samples) /= samples .or. law_start(law, states) /= 0) &
    call give_up(1, 'no start')
  y(:, 1) = states(3, :)
  y(:, 2) = states(6, :)

  open (newunit=file, file=trim(job) // '/courses.csv', action='write', recl=100000)
  write (file, '(a)', advance='no') 'time_s,input_torque_n_m,output_torque_n_m,output_angle_rad'
  external_sleeves = 0; internal_sleeves = 0
  do k = 1, n
    if (law_body(law, k - 1, carrier(k), seat(:, k), mass(k), moment(k)) /= 0) &
      call give_up(1, 'no such body')
    if (k > 2 .and. carrier(k) == -1) then
      write (file, '(a, i0)', advance='no') ',external_sleeve_force_n_', external_sleeves
      external_sleeves = external_sleeves + 1
    else if (carrier(k) == 1) then
      write (file, '(a, i0)', advance='no') ',internal_sleeve_force_n_', internal_sleeves
      internal_sleeves = internal_sleeves + 1
    end if
  end do
  ! States: with them Pinwheel says which part of a solver differs.
  wheels = n - 2 - external_sleeves - internal_sleeves
  call head('wheel_angle_rad_', wheels)
  write (file, '(a)', advance='no') ',output_rate_rad_s'
  call head('wheel_rate_rad_s_', wheels)
  call head('external_sleeve_rate_rad_s_', external_sleeves)
  call head('internal_sleeve_rate_rad_s_', internal_sleeves)
  write (file, '(a)')
  output_moment = moment(2) + sum(mass * (seat(1, :)**2 + seat(2, :)**2), mask=carrier == 1)

  all = 0
  do sample = 1, samples
    call evaluate(times(sample), y, first)
    driver = -loads(3, 1); output = loads(3, 2)
    do k = 3, n
      if (carrier(k) == 0) driver = driver - turning(k)
      if (carrier(k) == 1) output = output + turning(k)
    end do
    write (file, '(es24.16e3, 3(",", es24.16e3))', advance='no') times(sample), driver, output, y(2, 1)
    do k = 3, n
      if (carrier(k) /= 0) write (file, '(",", es24.16e3)', advance='no') hypot(loads(1, k), loads(2, k))
    end do
    write (file, '(*(:, ",", es24.16e3))', advance='no') states(3, 3:2 + wheels), states(6, 2:n)
    write (file, '(a)')
    if (mod(sample, 100_c_int64_t) == 1) write (0, '(a, es12.5)') '@t ', times(sample)
    if (sample == samples) exit
    ! Whole steps to the next sample, no longer than the scene's.
    steps = ceiling((times(sample + 1) - times(sample)) / law_step(law) * (1 - 1e-9_dp))
    h = (times(sample + 1) - times(sample)) / steps
    do step = 1, steps
      t = times(sample) + (step - 1) * h
      call evaluate(t, y, first)
      call evaluate(t + h, y + h * first, second)
      y = y + h / 2 * (first + second)
    end do
    all = all + steps
  end do
  close (file)
  open (newunit=file, file=trim(job) // '/result.json', action='write')
  write (file, '(a, i0, a, i0, a)') '{"steps": ', all, ', "degrees_of_freedom": ', n - 1, ', "settings": "Heun"}'
  close (file)
  call law_close(law)
contains
  ! Writes the names of columns with numbers from 0.
  subroutine head(name, count)
    character(*), intent(in) :: name
    integer, intent(in) :: count
    integer :: j
    write (file, '(*(a, i0))', advance='no') (',' // name, j, j = 0, count - 1)
  end subroutine
end program
